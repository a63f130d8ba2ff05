/** An edge that is dragged, or moved with the arrow keys, to give what lies beside it more room. */
interface Props {
  /** Whether the edge is upright. */
  upright: boolean;
  label: string;
  value: number;
  least: number;
  most: number;
  /** How much the value grows for one pixel to the right, or down. */
  sign: 1 | -1;
  onChange: (value: number) => void;
}

export function Splitter(p: Props) {
  const to = (value: number) => p.onChange(Math.round(Math.max(p.least, Math.min(p.most, value))));
  const down = (e: PointerEvent) => {
    const edge = e.currentTarget as HTMLElement;
    edge.setPointerCapture(e.pointerId);
    const start = p.upright ? e.clientX : e.clientY;
    const move = (m: PointerEvent) => to(p.value + p.sign * ((p.upright ? m.clientX : m.clientY) - start));
    const up = () => {
      edge.removeEventListener("pointermove", move);
      edge.removeEventListener("pointerup", up);
    };
    edge.addEventListener("pointermove", move);
    edge.addEventListener("pointerup", up);
  };
  const key = (e: KeyboardEvent) => {
    const way = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -1, ArrowDown: 1 }[e.key];
    if (!way || /Left|Right/.test(e.key) !== p.upright) return;
    e.preventDefault();
    e.stopPropagation();
    to(p.value + 20 * way * p.sign);
  };
  return (
    <div
      class={"splitter " + (p.upright ? "upright" : "level")}
      role="separator"
      tabindex={0}
      aria-label={p.label}
      aria-orientation={p.upright ? "vertical" : "horizontal"}
      aria-valuenow={p.value}
      aria-valuemin={p.least}
      aria-valuemax={p.most}
      onPointerDown={down}
      onKeyDown={key}
    />
  );
}
