"""``python -m osculate`` is the command line."""

from osculate.apps.cli import main

if __name__ == "__main__":
    main()
