"""What a run tells of itself in numbers: the methods of `Result` that measure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from hybond.measures.window import Time, window_of
from hybond.names import Asked

if TYPE_CHECKING:
    from hybond.measures.losses import Losses
    from hybond.result import Result


class Measuring(Asked):
    """Measurements and losses of a run; `Result` is the only one that has them."""

    def measure(self, *texts: str) -> Any:
        """Return measurements by text: ``run.measure("rms(out.e, period=20 us, periods=5)")``.

        Parameters
        ----------
        *texts : str
            A function of a signal, with arguments as the methods of `Signal` have them. Without
            any, what ``[experiment] measure`` asks for.

        Returns
        -------
        Measurement or dict
            Of one text its measurement, else ``{text: measurement}``.

        Raises
        ------
        UsageError
            HB-R120, HB-R121 for a text that asks for nothing; and those of the methods.

        Examples
        --------
        >>> import hybond as hb
        >>> m = hb.Model("rc", domain="electrical")
        >>> m.add(c=hb.C("1 mF", e="10 V"), r=hb.R("1 kohm"), node=hb.Zero())
        >>> m.bond("node -> c", "node -> r")
        >>> run = hb.simulate(m, until="1 s")
        >>> print(run.measure("mean(c.e)"))
        6.32121 V
        """
        from hybond.measures.asked import asked_of_experiment, measured, read_measure

        run = cast("Result", self)
        if not texts:
            return measured(run, asked_of_experiment(run.graph))
        found = measured(run, [read_measure(text) for text in texts])
        return found[texts[0].strip()] if len(texts) == 1 else found

    def losses(
        self,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        depth: int | None = None,
    ) -> Losses:
        """Return where the energy came from and where it went, element by element.

        Parameters
        ----------
        start, end, period, periods
            The window, as for `Signal.mean`; by default the whole run.
        depth : int, optional
            Add up submodels: paths of more than so many words.

        Raises
        ------
        UsageError
            HB-R101, HB-R102 no window of the run; HB-R113 for time-stepping.

        Examples
        --------
        >>> import hybond as hb
        >>> run = hb.simulate(hb.load("examples/capacitors_joined.toml"))
        >>> print(run.losses())
        t = 0 s to 2 s
        element  kind     supplied  dissipated  lost in jumps  stored
        C1       storage                                       -32 J
        C2       storage                                       20 J
        join     switch                         12 J
        total                                   12 J           -12 J
        """
        from hybond.measures.losses import losses_of

        run = cast("Result", self)
        window = window_of(run, start=start, end=end, period=period, periods=periods)
        found = losses_of(run, window)
        return found if depth is None else found.grouped(depth)

    def plot_losses(self, path: str | None = None, *, depth: int | None = None) -> Any:
        """Plot over time what was supplied, and where it went, stacked."""
        from hybond.draw.losses import plot_losses

        return plot_losses(self, path=path, depth=depth)

    def sankey(
        self,
        path: str | None = None,
        *,
        start: Time | None = None,
        end: Time | None = None,
        period: Time | None = None,
        periods: int | None = None,
        depth: int | None = None,
    ) -> Any:
        """Draw who gave energy and who took it; arguments as `losses`."""
        from hybond.draw.sankey import draw_sankey

        found = self.losses(start=start, end=end, period=period, periods=periods, depth=depth)
        return draw_sankey(found, title=cast("Result", self).title, path=path)
