"""The network of one tanh layer, with what its training needs; the published error model is `Network` 1-10-1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from stillrate import _native
from stillrate.rate_table.model import ErrorModel, wrap
from stillrate.rate_table.parts import Floats, as_floats, refusals


@dataclass(frozen=True, kw_only=True)
class Step:
    """One trial step of Levenberg-Marquardt.

    Attributes
    ----------
    step, gradient : ndarray, shape (parameters,)
        The step, and the gradient of the mean square.
    before, after : float
        Objective (mean square plus decay) before and after the step.
    mean_square : float
        Mean square of output less target before it.
    """

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
        Numbers of inputs and of hidden units.
    linear : bool
        Whether a straight line stands beside the hidden layer.

    Examples
    --------
    >>> net = Network(parameters=[3.0, 0.0, 2.0, 0.5], inputs=1, hidden=1)  # 0.5 + 2 tanh(3 x)
    >>> net.output([0.0]).tolist(), net.slope([0.0]).tolist()
    ([0.5], [6.0])
    >>> net.jacobian([0.0]).tolist()  # in W1, b1, W2, b2
    [[0.0, 2.0, 0.0, 1.0]]
    >>> step = net.step([-0.5, 0.5], [-1.0, 1.0])
    >>> step.after < step.before == step.mean_square
    True
    >>> curve = net.error_model([(-6.0, 12.0)], (-0.1, 0.2))  # rates of -6 to 6, errors of -0.1 to 0.1 deg/s
    >>> round(float(curve.predict([0.0])[0]), 12)
    0.05
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
        """Return one Levenberg-Marquardt step, whether or not it would be taken.

        Parameters
        ----------
        rows, targets : array_like
            Scaled inputs, shape (n, inputs) or (n,), and targets, shape (n,).
        decay, damping : float
            Weight decay and mu.
        decay_mask : array_like, shape (parameters,), optional
            1 for the parameters that decay, else 0; by default all weights but b2 and c.
        """
        mask = None if decay_mask is None else as_floats(decay_mask, "decay_mask")
        return Step(**refusals(self._compiled().step, _flat(rows), as_floats(targets, "targets"), decay, mask, damping))

    def error_model(self, input_scaling: list[tuple[float, float]], output_scaling: tuple[float, float]) -> ErrorModel:
        """Return the network as an (unchecked) error model; scalings are (smallest value, range)."""
        native = refusals(_native.RateTableModel.from_network, self._compiled(), input_scaling, output_scaling)
        return wrap(native)

    def _compiled(self) -> _native.RateTableNetwork:
        made: _native.RateTableNetwork = refusals(
            _native.RateTableNetwork, self.inputs, self.hidden, self.linear, as_floats(self.parameters, "parameters")
        )
        return made

    def _evaluate(self, rows: npt.ArrayLike) -> dict[str, Floats]:
        result: dict[str, Floats] = refusals(self._compiled().evaluate, _flat(rows))
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
    """Train a network on scaled samples: 70/15/15 split, early stopping.

    Parameters
    ----------
    rows, targets : array_like
        Inputs, shape (n, inputs) or (n,), and targets, shape (n,), both about -1..1.
    hidden, linear
        As in `Network`.
    decay : float, optional
        Weight decay.
    epochs, patience : int, optional
        Most epochs; epochs in a row without a better validation error that end the training (0: no validation).
    seed : int, optional
        Of the start and the split.

    Raises
    ------
    LogError
        Below ten samples a parameter, or if anything is not finite.

    Examples
    --------
    >>> x = np.linspace(-1.0, 1.0, 400)
    >>> net = train(x, 0.5 * x**2, hidden=4, linear=True)
    >>> bool(abs(net.output([0.6])[0] - 0.18) < 0.01)
    True
    """
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
