/** An outcome over two columns: cells of a grid or points, in colours; one opens the run behind it. */
import { useEffect, useRef, useState } from "preact/hooks";
import { GRADIENT, ends, named, said, scaleOf, viridis } from "./axes";
import type { OutcomeMap } from "./messages";

interface Props {
  found: OutcomeMap;
  wide: number;
  high: number;
  dark: boolean | null;
  chosen: number | null;
  choose: (member: number) => void;
  open: (member: number) => void;
}

const [LEFT, RIGHT, TOP, LOW] = [66, 12, 10, 38];
/** How near to a point a click has to be, pixels. */
const NEAR = 14;

export function Outcomes({ found, wide, high, dark, chosen, choose, open }: Props) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [over, setOver] = useState<number | null>(null);
  const beside = wide > 620;
  const [w, h] = [Math.max(wide - (beside ? 230 : 0), 160), high];
  const [across, up] = [w - LEFT - RIGHT, h - TOP - LOW];
  const x = scaleOf(found.x, found.across, Math.max(2, Math.round(across / 90)));
  const y = scaleOf(found.y, found.up, Math.max(2, Math.round(up / 50)));
  const columns = found.across.length;
  const grid = found.x.edges && found.y.edges ? { x: found.x.edges, y: found.y.edges } : null;
  const px = (v: number) => x.part(v) * across;
  const py = (v: number) => (1 - y.part(v)) * up;
  const at = (k: number): [number | null, number | null] => (grid ? [found.across[k % columns], found.up[Math.floor(k / columns)]] : [found.across[k], found.up[k]]);
  const numbers = found.number.filter((v): v is number => v !== null);
  const [least, most] = ends(numbers);
  const colour = (v: number | null) => (v === null ? found.none : found.names.length ? found.inks[v] : viridis(most > least ? (v - least) / (most - least) : 0.5));
  const outcome = (k: number) => (found.number[k] === null ? "no value" : found.names.length ? found.names[found.number[k]!] : said(found.number[k]));
  useEffect(() => {
    const e = canvas.current;
    const c = e?.getContext("2d");
    if (!e || !c) return;
    const dots = devicePixelRatio || 1;
    [e.width, e.height] = [across * dots, up * dots];
    c.setTransform(dots, 0, 0, dots, 0, 0);
    c.clearRect(0, 0, across, up);
    const edge = getComputedStyle(e).getPropertyValue("--off");
    found.number.forEach((v, k) => {
      if (found.members[k] < 0) return;
      c.fillStyle = colour(v);
      if (grid) {
        const [i, j] = [k % columns, Math.floor(k / columns)];
        const [a, b] = [Math.round(px(grid.x[i]) * dots) / dots, Math.round(px(grid.x[i + 1]) * dots) / dots];
        const [d, e] = [Math.round(py(grid.y[j + 1]) * dots) / dots, Math.round(py(grid.y[j]) * dots) / dots];
        c.fillRect(a, d, b - a, e - d);
        return;
      }
      const [a, b] = at(k);
      if (a === null || b === null) return;
      c.beginPath();
      c.arc(px(a), py(b), found.members.length > 2000 ? 2 : 3.6, 0, 7);
      c.fill();
      c.strokeStyle = edge;
      c.lineWidth = 0.5;
      c.stroke();
    });
  }, [found, w, h, dark]);
  const nearest = (e: MouseEvent): number | null => {
    const r = (e.currentTarget as HTMLElement).getBoundingClientRect();
    const [a, b] = [e.clientX - r.left, e.clientY - r.top];
    if (grid) {
      const [i, j] = [grid.x.findIndex((v) => px(v) > a) - 1, grid.y.findIndex((v) => py(v) < b) - 1];
      const k = j * columns + i;
      return i >= 0 && j >= 0 && found.members[k] >= 0 ? k : null;
    }
    let [best, far] = [-1, NEAR ** 2];
    found.members.forEach((_, k) => {
      const [v, u] = at(k);
      const d = v === null || u === null ? Infinity : (px(v) - a) ** 2 + (py(u) - b) ** 2;
      if (d < far) [best, far] = [k, d];
    });
    return best < 0 ? null : best;
  };
  const place = chosen === null ? -1 : found.members.indexOf(chosen);
  const key = (e: KeyboardEvent) => {
    if (e.key === "Enter" && chosen !== null) return open(chosen);
    const step = { ArrowRight: 1, ArrowLeft: -1, ArrowUp: grid ? columns : 1, ArrowDown: grid ? -columns : -1 }[e.key];
    if (!step) return;
    e.preventDefault();
    const next = place < 0 ? 0 : place + step;
    if (found.members[next] >= 0) choose(found.members[next]);
  };
  const lost = found.members.filter((m, k) => m >= 0 && !grid && at(k).includes(null)).length;
  const shown = over ?? (place < 0 ? null : place);
  const word = (k: number) => {
    const [a, b] = at(k);
    return `run ${found.members[k]}: ${found.x.name} = ${said(a)}, ${found.y.name} = ${said(b)}, ${found.value} = ${outcome(k)}`;
  };
  const [cx, cy] = place < 0 ? [null, null] : at(place);
  return (
    <figure class={"outcomes" + (beside ? " beside" : "")} data-view={found.view}>
      <div class="area" style={`width: ${w}px; height: ${h}px`} tabindex={0} role="group" aria-label={`${found.value} over ${found.x.name} and ${found.y.name}, ${grid ? "cells" : "points"}. Arrows choose a run, Enter opens it.`} onKeyDown={key}>
        <canvas
          ref={canvas}
          style={`left: ${LEFT}px; top: ${TOP}px; width: ${across}px; height: ${up}px`}
          data-span={JSON.stringify([x.low, x.high, y.low, y.high])}
          onMouseMove={(e) => setOver(nearest(e))}
          onMouseLeave={() => setOver(null)}
          onClick={(e) => {
            const k = nearest(e);
            if (k !== null) {
              choose(found.members[k]);
              open(found.members[k]);
            }
          }}
        />
        <svg width={w} height={h} role="img" aria-label={`${found.value}: ${found.names.length ? found.names.join("; ") : `${said(least)} to ${said(most)} ${found.unit}`}`}>
          <rect class="box" x={LEFT} y={TOP} width={across} height={up} />
          {x.ticks.map((v) => (
            <g>
              <line class="tick" x1={LEFT + px(v)} x2={LEFT + px(v)} y1={TOP + up} y2={TOP + up + 4} />
              <text x={LEFT + px(v)} y={TOP + up + 15} text-anchor="middle">{said(v)}</text>
            </g>
          ))}
          {y.ticks.map((v) => (
            <g>
              <line class="tick" x1={LEFT - 4} x2={LEFT} y1={TOP + py(v)} y2={TOP + py(v)} />
              <text x={LEFT - 7} y={TOP + py(v) + 3.5} text-anchor="end">{said(v)}</text>
            </g>
          ))}
          <text class="what" x={LEFT + across / 2} y={h - 6} text-anchor="middle">{named(found.x.name, found.x.unit)}</text>
          <text class="what" transform={`translate(12,${TOP + up / 2}) rotate(-90)`} text-anchor="middle">{named(found.y.name, found.y.unit)}</text>
          {cx !== null && cy !== null && <circle class="chosen" cx={LEFT + px(cx)} cy={TOP + py(cy)} r={7} />}
        </svg>
      </div>
      <figcaption>
        <b>{named(found.value, found.unit)}</b>
        {found.names.map((name, k) => (
          <span class="key">
            <i style={`background: ${found.inks[k]}`} /> {name}
          </span>
        ))}
        {!found.names.length && numbers.length > 0 && (
          <span class="bar">
            <i style={`background: linear-gradient(to right, ${GRADIENT})`} />
            <span>{said(least)}</span>
            <span>{said(most)}</span>
          </span>
        )}
        {!found.names.length && found.members.some((m, k) => m >= 0 && found.number[k] === null) && (
          <span class="key">
            <i style={`background: ${found.none}`} /> no value
          </span>
        )}
        {found.members.length < found.all && <small>{found.members.length} of {found.all} runs are drawn</small>}
        {lost > 0 && <small>{lost === 1 ? "1 run has" : `${lost} runs have`} no value for an axis</small>}
        <output>{shown !== null && found.members[shown] >= 0 ? word(shown) : ""}</output>
      </figcaption>
    </figure>
  );
}
