"""Records as labelled data: xarray in memory, netCDF on disk."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from osculate.simulation.loop import Setup
from osculate.simulation.metrics import Metrics
from osculate.simulation.variables import BY_NAME
from osculate.simulation.verdict import Verdict
from osculate.strict_json import strict_json

if TYPE_CHECKING:
    import xarray

    from osculate.simulation.batch import Batch
    from osculate.simulation.run import Run


def attributes(setup: Setup) -> dict[str, str]:
    """The global attributes of a record: what was run, as JSON a scenario file could hold."""
    return {"source": "osculate", "setup": strict_json(plain_parts(setup))}


def verdict_labels(verdict: Verdict) -> dict[str, str]:
    """The verdict as global attributes: its kind, its sentence, and all of it as JSON."""
    return {
        "verdict": str(verdict.kind),
        "ended": verdict.sentence,
        "verdict_details": strict_json(verdict.as_dict()),
    }


def plain_parts(setup: Setup) -> dict[str, Any]:
    """The parts of a setup as plain data, by name."""

    def plain(part: Any) -> Any:
        if isinstance(part, tuple):
            return [plain(item) for item in part]
        return None if part is None else part.model_dump(mode="json")

    return {name: plain(part) for name, part in setup._asdict().items()}


def run_dataset(run: "Run") -> "xarray.Dataset":
    """The record of one run over ``time``."""
    import xarray

    time = BY_NAME["time"]
    known = (BY_NAME[name] for name in run.columns if name != "time")
    variables = {
        v.name: ("time", run.columns[v.name], {"units": v.unit, "long_name": v.long_name})
        for v in known
    }
    return xarray.Dataset(
        variables,
        coords={"time": ("time", run.columns["time"], {"units": "s", "long_name": time.long_name})},
        attrs={**attributes(run.setup), **verdict_labels(run.verdict)},
    )


def batch_dataset(batch: "Batch") -> "xarray.Dataset":
    """Metrics of a batch over ``run``, with what was varied as coordinates, and the record if any."""
    import xarray

    metrics = {
        name: ("run", np.asarray(value), {"units": unit, "long_name": label})
        for (name, unit, label), value in zip(
            Metrics.items(), batch.metrics.as_dict().values(), strict=True
        )
        if value is not None
    }
    series = {
        v.name: (("run", "time"), batch.record[..., n], {"units": v.unit, "long_name": v.long_name})
        for n, v in enumerate(batch.variables)
        if len(batch.time) and v.name != "time"
    }
    kinds = np.array([str(verdict.kind) for verdict in batch.verdicts])
    return xarray.Dataset(
        {**metrics, "verdict": ("run", kinds, {"long_name": "what became of the run"}), **series},
        coords={
            **{name: ("run", np.asarray(values)) for name, values in batch.varied.items()},
            **({"time": ("time", batch.time, {"units": "s"})} if len(batch.time) else {}),
        },
        attrs=attributes(batch.setup),
    )


def write_netcdf(run: "Run", path: Path) -> Path:
    """Write the record as a netCDF-3 file by SciPy, which needs no xarray to be imported."""
    from scipy.io import netcdf_file

    with netcdf_file(path, "w", version=2) as file:
        file.createDimension("time", len(run.columns["time"]))
        for v in (BY_NAME[name] for name in run.columns):
            variable = file.createVariable(v.name, np.dtype(">f8"), ("time",))
            variable[:] = run.columns[v.name]
            _label(variable, {"units": v.unit, "long_name": v.long_name})
        _label(file, {**attributes(run.setup), **verdict_labels(run.verdict)})
    return path


def _label(target: Any, labels: dict[str, str]) -> None:
    for name, text in labels.items():
        setattr(target, name, text.encode("utf-8"))
