"""Statements about Figures 3 to 6, Section 5."""

import math

import numpy as np

from osculate.simulation import Run
from osculate.study.paper.claims.claim import Claim, Condition, Evidence, observed, printed
from osculate.study.paper.measures import lost_at, rms, sum_of_squares
from osculate.study.paper.readings import NEAR, agreeing, in_words, square_sum_words

EXACT, PRINTED_SUM = 1e-8, 6.3217  # m; m²


def figure_claims(evidence: Evidence) -> list[Claim]:
    """Undisturbed runs, the figures in all readings, and the numbers of Figure 6."""
    return [
        *_undisturbed(evidence),
        *_figures(evidence),
        *_internal(evidence),
        *_external(evidence),
    ]


def ending(run: Run) -> str:
    """How a run ended, as a sentence."""
    sentence = run.verdict.sentence
    return f"{sentence[0].upper()}{sentence[1:]}."


def _undisturbed(evidence: Evidence) -> list[Claim]:
    runs = evidence.runs
    exact = {name: rms(runs[name]) for name in ("modified", "printed")}
    static, pushed = rms(runs["static"]), rms(runs["static_d2"])
    return [
        observed(
            "rms_modified_nominal", "modified target, undisturbed: exact tracking", "Section 3, eq. (30)",
            "exact", exact["modified"], "m", f"√(J_a/N) < {EXACT:g} m", exact["modified"] < EXACT,
            note=ending(runs["modified"]),
        ),
        observed(
            "rms_printed_nominal", "modified target with the printed ¾: exact tracking", "eq. (50)",
            "exact", exact["printed"], "m", "√(J_a/N) < 1e-5 m", exact["printed"] < 1e-5,
            note=ending(runs["printed"]), erratum=4,
        ),
        observed(
            "rms_static_nominal", "static target, undisturbed: errors remain",
            "Section 5.1, paragraph after (51), sentence 4", "errors accumulate", static, "m",
            "√(J_a/N) > 1e-3 m", static > 1e-3,
            note=f"without d₂; with it {1e3 * pushed:.3g} mm. {ending(runs['static'])}",
        ),
    ]  # fmt: skip


def _figures(evidence: Evidence) -> list[Claim]:
    said = {
        (3,): ("speed errors are small and the path nearly coincides", "sentences 1-3", "off the path"),
        (4,): ("speed errors start large and the path deviates significantly", "sentences 4-5", ""),
        (3, 4): ("modified and static target differ as said, in one reading", "", ""),
        (5,): ("speed errors grow without bound, the path is held", "Section 5.2, sentence 4", ""),
    }  # fmt: skip
    found = []
    for figures, (statement, where, _) in said.items():
        fits = agreeing(evidence.readings, *figures)
        name, words = "_".join(map(str, figures)), " and ".join(map(str, figures))
        section = (
            where if where.startswith("Section") else f"Section 5.1, paragraph after (51) {where}"
        )
        found.append(observed(
            f"figure_{name}", f"Figure {words}: {statement}", f"Figure {words}, {section}".strip(),
            "both, over 20 s", float(len(fits)), "readings of 4",
            "premise and conclusion hold for both signs of d₁ and both θ̂(0)", len(fits) == 4,
            Condition(in_words(fits), bool(fits)),
            note="see the table of readings",
        ))  # fmt: skip
    return found


def _internal(evidence: Evidence) -> list[Claim]:
    """The rms errors behind Figures 3 to 5, as this run interprets the text."""
    near = "nearly coincides with the path"
    rows = []
    for name, words, figure in (
        ("modified_d1", "d₁ = (5y₁, 5y₂)", 3), ("modified_d1_minus", "d₁ = −(5y₁, 5y₂)", 3),
        ("modified_d11", "d₁₁ = (12y₁, 11.2y₂)", 5), ("modified_d11_minus", "d₁₁ = −(12y₁, 11.2y₂)", 5),
    ):  # fmt: skip
        value = rms(evidence.runs[name])
        rows.append(observed(
            f"rms_{name}", f"modified target under {words}", f"Figure {figure}b",
            near if figure == 3 else "satisfactory", value, "m", f"√(J_a/N) < {NEAR:g} m", value < NEAR,
            Condition("errors of up to 10 cm satisfy", value < 0.1), note=ending(evidence.runs[name]),
        ))  # fmt: skip
    for name, words in (("static_d1", "d₁ = (5y₁, 5y₂)"), ("static_d1_minus", "d₁ = −(5y₁, 5y₂)")):
        run = evidence.runs[name]
        value, lost = rms(run), lost_at(run)
        left = "it is never 2 m off" if lost is None else f"it is 2 m off after {lost:.3f} s"
        rows.append(observed(
            f"rms_{name}", f"static target under {words}", "Figure 4b", "deviates significantly", value,
            "m", "√(J_a/N) > 0.1 m, or 2 m off the path", value > 0.1 or lost is not None,
            note=f"Until 2 m off the path; {left}.",
        ))  # fmt: skip
    return rows


def _external(evidence: Evidence) -> list[Claim]:
    run, turned = (evidence.runs[f"modified_d12{end}"] for end in ("", "_heading_disturbed"))
    value, literal = rms(run), rms(turned)
    late = run.columns["time"] > 0.5 * run.columns["time"][-1]
    left = float(np.abs(run.columns["yaw_rate_error"][late]).max())
    total = sum_of_squares(run)
    words = square_sum_words(evidence.square_sums, PRINTED_SUM)
    return [
        observed(
            "errors_remain_d12", "the speed errors do not converge to zero under d₁₂",
            "Section 5.2, paragraph 3, sentence 2, Figure 6a", "not convergent", left, "rad/s",
            "|θ̇ − θ̂̇| in the second half of the run reaches 1e-3 rad/s", left > 1e-3,
        ),
        observed(
            "rms_modified_d12", "modified target under d₁₂ = (sin 4t, cos 4t): √(J_a/N) < 0.02 m",
            "Section 5.2, last paragraph, Figure 6", f"{math.sqrt(PRINTED_SUM / 20000):.4f} m", value, "m",
            f"√(J_a/N) < {NEAR:g} m", value < NEAR, note=ending(run),
        ),
        printed(
            "sum_of_squares_d12", "J_a of Figure 6", "Section 5.2, last paragraph", PRINTED_SUM, total,
            "m²", note=words, erratum=10,
        ),
        observed(
            "rms_modified_d12_heading_disturbed", "modified target when d₁₂ turns the robot itself",
            "Section 5.2 read literally", "the path is followed effectively", literal, "m",
            f"√(J_a/N) < {NEAR:g} m", literal < NEAR,
            Condition("d₁₂ acts on the law's heading coordinate, not on the robot", value < NEAR),
            note=f"Pure curvature tracking has no feedback of the pose. {ending(turned)}",
        ),
    ]  # fmt: skip
