"""Scenario files: the same fields as the Python objects, and errors that say what to change."""

import pytest
from pydantic import TypeAdapter

from osculate import (
    Continuous,
    Cycloid,
    Disturbance,
    InvalidInput,
    InvalidScenario,
    Mujoco,
    NoSolution,
    Scenario,
    Scene,
    Static,
    simulate,
)
from osculate.simulation.loop import Setup
from osculate.simulation.run import make_setup
from osculate.study.scenario import AnyController, built_in

CONTROLLERS = TypeAdapter(AnyController).json_schema()["discriminator"]["mapping"]

pytestmark = pytest.mark.core


def write(folder, text):
    path = folder / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_all_built_in_scenarios_load_and_describe_themselves():
    assert set(built_in()) >= {"paper", "paper-static", "paper-disturbed", "projected"}
    for name in built_in():
        scenario = Scenario.load(name)
        assert scenario.name == name
        assert scenario.description


def test_the_default_is_the_papers_experiment():
    assert Scenario.load("paper").parts == {
        **Scenario().parts,
        "scene": Scenario.load("paper").scene,
    }
    assert Scenario.load("paper-disturbed").disturbance == Disturbance.external()


@pytest.mark.parametrize("kind", CONTROLLERS)
def test_files_and_python_have_the_same_defaults(tmp_path, kind):
    text = f"curve: {{kind: line, distance: 2}}\ncontroller: {{kind: {kind}}}\n"
    scenario = Scenario.load(write(tmp_path, text))
    given = {"curve": scenario.curve, "robot": None, "parts": {"controller": scenario.controller}}
    setup = make_setup(**given)
    assert {name: getattr(scenario, name) for name in Setup._fields} == setup._asdict()
    assert type(scenario.controller)() == scenario.controller
    assert set(Scenario.model_fields) == {*Setup._fields, "name", "description", "scene"}


def test_without_a_scene_there_is_no_obstacle(tmp_path):
    path = write(tmp_path, "clock: {kind: continuous, duration: 0.01}")
    there = Scenario.load(path).run()
    here = simulate(Cycloid(), clock=Continuous(duration=0.01))
    assert there.scene == here.scene == Scene()
    assert there.metrics == here.metrics
    assert there.metrics.clearance_min is None
    for name in ("paper", "paper-static", "paper-disturbed"):
        assert not Scenario.load(name).scene.is_empty


def test_another_plant_keeps_what_the_scenario_says_of_its_own(tmp_path):
    text = "curve: {kind: line, distance: 2}\ncontroller: {kind: lqr}\n"
    loaded = Scenario.load(write(tmp_path, text + "plant: {kind: actuated, payload: 2.0}"))
    assert loaded.on("mujoco").plant == Mujoco(payload=2.0)
    assert loaded.on("slip").on("actuated") == loaded
    slippery = Scenario.load(write(tmp_path, text + "plant: {kind: slip, stiffness: 9.0}"))
    with pytest.raises(InvalidInput, match=r"plant.stiffness = 9.0: does not fit the plant mujoco"):
        slippery.on("mujoco")


def test_a_scenario_is_its_dump():
    scenario = Scenario.load("paper-static")
    assert isinstance(scenario.target, Static)
    assert Scenario.parse(scenario.model_dump(mode="json")) == scenario


def test_the_cycloid_goes_over_the_first_wall(tmp_path):
    path = write(
        tmp_path,
        """
        scene: {obstacles: [{kind: wall, distance: 8.0, height: 2.0}]}
        curve: {kind: cycloid, margin: 0.5}
        """,
    )
    assert Scenario.load(path).curve == Cycloid.over(8.0, 2.0, 0.5)
    path = write(tmp_path, "scene: {obstacles: [{kind: wall, distance: 8.0, height: 2.0}]}")
    assert Scenario.load(path).curve == Cycloid(distance=8.0, height=2.0)


def test_running_a_scenario_is_calling_simulate():
    scenario = Scenario.load("paper-static")
    run = scenario.run()
    again = simulate(scenario.curve, scenario.robot, **scenario.parts)
    assert run.metrics == again.metrics
    assert 0.0 < run.metrics.clearance_min < 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("robot: {body_mass: -3}", r"robot\.body_mass = -3: must be greater than 0 \(kg\)"),
        ("curve: {kind: cycloid, margin: -1}", r"curve\.cycloid\.margin = -1: must be .* 0 \(m\)"),
        ("robot: {weight: 3}", r"robot\.weight = 3: unknown field; valid fields: kind, body_mass"),
        ("robots: {}", "robots = {}: unknown field; valid fields: name, description, scene"),
        (
            "curve: {kind: circle}",
            r"curve\.kind = 'circle': must be one of 'cycloid', 'parametric'",
        ),
        ("clock: {step: 0.001}", "clock = .*needs a field 'kind'"),
        ("clock: {kind: continuous, step: .nan}", "step = nan"),
        ("[1, 2]", "must hold a mapping"),
        ("curve: {kind: cycloid", "is not valid YAML at line 1"),
        ("", "must hold a mapping"),
    ],
)
def test_a_wrong_file_is_explained(tmp_path, text, message):
    with pytest.raises(InvalidInput, match=message):
        Scenario.load(write(tmp_path, text))


def test_all_wrong_fields_are_listed_at_once(tmp_path):
    path = write(tmp_path, "robot: {body_mass: 0, wheelbase: x}\nclock: {kind: sampled, period: 0}")
    with pytest.raises(InvalidScenario) as caught:
        Scenario.load(path)
    assert len(caught.value.problems) == 3
    assert all("must be" in problem.valid for problem in caught.value.problems)


def test_an_impossible_cycloid_says_what_would_do(tmp_path):
    path = write(tmp_path, "curve: {kind: cycloid, distance: 5, height: 5}")
    with pytest.raises(NoSolution, match=r"increase distance above 9\.425 m"):
        Scenario.load(path)


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(InvalidInput, match="must be a YAML file or one of: paper, paper-disturbed"):
        Scenario.load("papr")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("name: a\nname: b\n", "line 2.*'name' is there twice"),
        ("limits: {speed: 010}\n", "line 1.*010 is not the same number everywhere"),
        ("limits: {speed: 1:30}\n", "line 1.*1:30 is not the same"),
        ("limits: {speed: 0x1F}\n", "line 1.*0x1F"),
        ("a: " + "[" * 5000, "nested more than"),
        ("a: &a [1]\n" + "".join(f"b{n}: &a [{'*a, ' * 9}*a]\n" for n in range(9)), "too large"),
    ],
)
def test_scenarios_are_read_strictly(tmp_path, text, message):
    with pytest.raises(InvalidInput, match=message):
        Scenario.load(write(tmp_path, text))


def test_a_quoted_text_may_look_like_any_number(tmp_path):
    assert Scenario.load(write(tmp_path, 'name: "010"\ndescription: "1:30"\n')).name == "010"
