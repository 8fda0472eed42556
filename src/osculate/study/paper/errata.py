"""What is wrong or left open in the paper, in the order of the theory page."""

ERRATA = (
    "The steering term. (16), (47) and (A10) print I a r² where the paper's own energies give I "
    "r²; with its numbers 10.8 instead of 27. Only the derived one conserves energy.",
    "The rod. I_b is defined about O, yet (a²/4) M_b is added to it again. The value is kept as "
    "the paper's robot.",
    "The yaw input. u₁ = T_l − T_r is no free input: θ̇ = (r/d)(θ̇_l − θ̇_r) is missing in F; "
    "with it the rank is 4 and u₁ = (d I_w / r) θ̈, what an open differential leaves between the "
    "wheels.",
    "The profile. θ̂̇ = −¾ t e^{−t/2} (50) turns by −3 rad, the path by −(π − β) = −2.6295 rad: "
    "the robot is at the end after 7.245 s, still moving. ¾ = (μ/2) · 6 · γ² suggests that 6 was "
    "taken for 2π − 2β = 5.259.",
    "The start. From rest, the static target asks for more than 1,100 N m from a robot of 9 kg.",
    "The sliding mode. (39) lacks the nominal part −∫κz dt of an integral sliding mode, (40) the "
    "input gain, and E = 0.2 does not bound the part 2z of d₂.",
    "The steering angle. (36) takes ∫c u₁ dt for θ̇. A disturbed yaw rate differs from it (by "
    "0.25 rad/s under d₁₂); the angle that keeps the constraint (6) is arctan(aθ̇/v).",
    "Statements about the motion. The curve does not depend on μ, only when a point is reached; "
    "the speed of P across OP is aθ̇, not zero.",
    "The target's acceleration. After (37), dv̂/dt is printed with an extra 2: it is k(s) (4α "
    "cos(β/2) − s) v θ̇ + c u₁ / k(s).",
    "The sum of squares. J_a depends on θ̂(0), constants, integrator and on what happens after s "
    "= l, which the text leaves open.",
)
