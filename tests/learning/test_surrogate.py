"""What every row of the table of methods promises, and that a method is only there."""

import ast
from pathlib import Path

import numpy as np
import pytest
import torch

import physgnn
from physgnn.dataset.splits.samples import Split
from physgnn.dataset.storage.store import Store
from physgnn.errors import InputError
from physgnn.learning.models import MODELS, build_model, is_model, model_class
from physgnn.learning.network import Network
from physgnn.learning.runs.checkpoint import Checkpoint
from physgnn.learning.surrogate import FromFunction, Surrogate
from physgnn.mechanics.loads.paths import LoadCase

SMALL = {  # options that make a method quick enough for a test
    "pod-network": {"width": 8, "epochs": 2},
    "extra-trees": {"trees": 2},
    "mlp": {"width": 8, "epochs": 2},
    "galerkin": {"pod_modes": 3},
    "reduced": {"anchors": 3},
    "meshgraphnet": {"width": 8, "steps": 2},
    "transolver": {"width": 8, "layers": 2, "heads": 2, "slices": 4},
    "cnn": {"cells": 8, "width": 4, "levels": 2},
    "lifted": {"width": 8, "layers": 2, "pod_modes": 2, "anchors": 2},
    "physgnn": {"width": 8},
}
TINY = 1e-20


def fitted(name: str, store: Store, split: Split, seed: int = 0) -> Surrogate:
    torch.manual_seed(seed)
    surrogate = build_model(name, store.body, **SMALL.get(name, {}))
    surrogate.fit(store, split.train, seed)
    return surrogate


@pytest.fixture(params=MODELS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def case_for(name: str, store: Store, split: Split) -> LoadCase:
    """A load that a method can answer, not trained on if there is one."""
    asked = split.train if name == "interpolation" else split.test
    path, level = asked[-1].tolist()
    return store.load_case(path, level)


def test_it_predicts_and_is_the_same_after_saving_and_with_its_seed(
    name: str, store: Store, split: Split, tmp_path: Path
) -> None:
    surrogate, case = fitted(name, store, split), case_for(name, store, split)
    displacement = surrogate.predict(case)
    assert displacement.shape == store.mesh.points.shape
    assert displacement.dtype == np.float64
    assert np.isfinite(displacement).all()
    assert displacement.any() == (name != "zero")
    record = {"config": {"model": name, "options": SMALL.get(name, {})}}
    Checkpoint(surrogate, record).save(tmp_path)
    again = Checkpoint.load(tmp_path).model
    np.testing.assert_array_equal(again.predict(case), displacement)
    np.testing.assert_array_equal(again.linear(case), surrogate.linear(case))
    same = fitted(name, store, split)
    np.testing.assert_array_equal(same.predict(case), displacement)
    if surrogate.draws and not isinstance(surrogate, Network):  # which are not trained
        other = fitted(name, store, split, seed=1)
        assert (other.predict(case) != displacement).any()


def test_fixed_points_stay(name: str, store: Store, split: Split) -> None:
    if name == "physgnn":
        pytest.skip("the published network is told which points are fixed, no more")
    displacement = fitted(name, store, split).predict(case_for(name, store, split))
    assert not displacement[store.fixed].any()


def test_without_load_nothing_moves_where_that_is_promised(
    name: str, store: Store, split: Split
) -> None:
    surrogate, case = fitted(name, store, split), case_for(name, store, split)
    if not surrogate.zero_without_load:
        pytest.skip("not promised")
    tiny = surrogate.predict(LoadCase(case.nodes, TINY * case.forces))
    assert np.abs(tiny).max() < 1e-12


def test_what_learns_nothing_needs_nothing(
    name: str, store: Store, split: Split
) -> None:
    method, nothing = model_class(name), split.train[:0]
    assert method.applies_to(store, split.train, split.train)
    interpolates = name == "interpolation"
    expected = not (method.learns or interpolates)
    assert method.applies_to(store, nothing, split.test) == expected


def test_it_is_warmed_up_by_loads_it_can_answer(
    name: str, store: Store, split: Split
) -> None:
    surrogate = fitted(name, store, split)
    for case in surrogate.warm_up_cases():
        case.check_against(store.mesh, store.fixed)
        assert np.isfinite(surrogate.predict(case)).all()


def test_no_module_but_the_table_names_a_methods_class() -> None:
    """So that a method is one file and one row."""
    modules = {path.split(":")[0]: path.split(":")[1] for path in MODELS.values()}
    root = Path(physgnn.__file__).parent
    for file in root.rglob("*.py"):
        own = ".".join(["physgnn", *file.relative_to(root).with_suffix("").parts])
        tree = ast.walk(ast.parse(file.read_text("utf-8")))
        imported = {
            (node.module, alias.name)
            for node in tree
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        others = {each for each in modules.items() if each[0] != own}
        assert not imported & others, file


def test_only_networks_need_torch_of_their_author() -> None:
    kinds = {name for name in MODELS if issubclass(model_class(name), Network)}
    modules = {
        name for name in MODELS if issubclass(model_class(name), torch.nn.Module)
    }
    assert kinds == modules == {
        "cnn", "lifted", "meshgraphnet", "physgnn", "transolver",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("magic", r"no model 'magic' \(there are: .*module:Class"),
        ("nowhere_at_all:Method", "cannot be imported"),
        ("physgnn.errors:Magic", "cannot be imported"),
        ("physgnn.errors:InputError", "derived from"),
        ("lifted:", "no model 'lifted:'"),
    ],
)
def test_what_is_no_method_is_refused(name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        model_class(name)


def test_unknown_options_name_those_there_are(store: Store) -> None:
    with pytest.raises(InputError, match=r"no option 'reach' \(it has: none\)"):
        build_model("zero", store.body, reach=3)
    assert is_model("my_module:MyMethod")


def test_a_precision_that_changes_nothing_is_refused(store: Store) -> None:
    with pytest.raises(InputError, match="leave precision at float32"):
        build_model("linear", store.body).prepare(precision="bfloat16")


def test_a_function_is_a_surrogate(store: Store) -> None:
    case = store.load_case(0, 0)
    linear = build_model("linear", store.body)
    twice = FromFunction(store.body, lambda each: 2.0 * linear.predict(each))
    np.testing.assert_allclose(twice.predict(case), 2.0 * twice.linear(case))
