"""``python -m osculate`` and ``osculate`` are the command line."""

from osculate.apps.interrupt import interruptible


def main() -> None:
    """Entry point: Ctrl-C ends it from here on, also while the command line is still being loaded."""
    with interruptible():
        from osculate.apps.cli import main as run

        run()


if __name__ == "__main__":
    main()
