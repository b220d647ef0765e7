"""The network of one tanh layer, with what its training needs; the published error model is `Network` 1-10-1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.rate_table.model import ErrorModel
from stillrate.rate_table.parts import Floats, as_floats, refusals


@dataclass(frozen=True, kw_only=True)
class Step:
    """One trial step of Levenberg-Marquardt: the step, the objective before and after, mean square and gradient."""

    step: Floats
    before: float
    after: float
    mean_square: float
    gradient: Floats


@dataclass(frozen=True, kw_only=True, eq=False)
class Network:
    """e = b2 + W2 tanh(W1 x + b1) [+ c.x], inputs and output in scaled units (about -1..1).

    Parameters
    ----------
    parameters : array_like
        W1 row by row (hidden x inputs), b1, W2, b2 and, if `linear`, c.
    inputs, hidden : int
    linear : bool
        Whether a straight line stands beside the hidden layer.

    Examples
    --------
    >>> net = Network(parameters=np.zeros(31), inputs=1, hidden=10)
    >>> net.output([0.5]).tolist()
    [0.0]
    """

    parameters: npt.ArrayLike
    inputs: int = 1
    hidden: int = 10
    linear: bool = False

    def output(self, rows: npt.ArrayLike) -> Floats:
        """Return the output at rows of inputs, shape (n, inputs) or (n,) -> (n,)."""
        result: Floats = self._evaluate(rows)["output"]
        return result

    def slope(self, rows: npt.ArrayLike) -> Floats:
        """Return the derivative of the output in the first input, shape (n,)."""
        result: Floats = self._evaluate(rows)["slope"]
        return result

    def jacobian(self, rows: npt.ArrayLike) -> Floats:
        """Return the derivatives of the output in the parameters, shape (n, parameters)."""
        flat: Floats = self._evaluate(rows)["jacobian"]
        return flat.reshape(-1, np.size(self.parameters))

    def step(
        self,
        rows: npt.ArrayLike,
        targets: npt.ArrayLike,
        *,
        decay: float = 0.0,
        damping: float = 1e-3,
        decay_mask: npt.ArrayLike | None = None,
    ) -> Step:
        """Return one Levenberg-Marquardt step, whether or not it would be taken."""
        mask = None if decay_mask is None else as_floats(decay_mask, "decay_mask")
        done = refusals(
            _native.network_step, *self._shape(), _flat(rows), as_floats(targets, "targets"), decay, mask, damping
        )
        return Step(
            step=done["step"],
            before=done["before"],
            after=done["after"],
            mean_square=done["mse"],
            gradient=done["gradient"],
        )

    def error_model(self, input_scaling: list[tuple[float, float]], output_scaling: tuple[float, float]) -> ErrorModel:
        """Return the network as an (unchecked) error model; scalings are (smallest value, range)."""
        parameters = as_floats(self.parameters, "parameters").tolist()
        native = refusals(
            _native.RateTableModel.from_network,
            self.inputs,
            self.hidden,
            self.linear,
            parameters,
            input_scaling,
            output_scaling,
        )
        return ErrorModel.from_native(native)

    def _shape(self) -> tuple[int, int, bool, Floats]:
        return self.inputs, self.hidden, self.linear, as_floats(self.parameters, "parameters")

    def _evaluate(self, rows: npt.ArrayLike) -> dict[str, Floats]:
        result: dict[str, Floats] = refusals(_native.network_evaluate, *self._shape(), _flat(rows))
        return result


def train(
    rows: npt.ArrayLike,
    targets: npt.ArrayLike,
    *,
    hidden: int = 10,
    linear: bool = False,
    decay: float = 0.0,
    epochs: int = 1000,
    patience: int = 6,
    seed: int = 1,
) -> Network:
    """Train a network on scaled samples: 70/15/15 split, early stopping; refused below ten samples a parameter."""
    array = np.asarray(rows, dtype=np.float64)
    inputs = 1 if array.ndim == 1 else array.shape[1]
    parameters, _, _ = refusals(
        _native.network_train,
        inputs,
        hidden,
        linear,
        _flat(rows),
        as_floats(targets, "targets"),
        decay,
        epochs,
        patience,
        seed,
    )
    return Network(parameters=parameters, inputs=inputs, hidden=hidden, linear=linear)


def _flat(rows: npt.ArrayLike) -> Floats:
    return np.ascontiguousarray(rows, dtype=np.float64).ravel()
