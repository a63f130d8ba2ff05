/** The schematic of the level beside its bond graph: drawn by the session, selected here. */
import { useEffect, useState } from "preact/hooks";
import type { Scene } from "./messages";
import { Refused } from "./transport";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

export function Schematic({ store, state }: Props) {
  const [scene, setScene] = useState<Scene | null>(null);
  const [why, setWhy] = useState("");
  const look = state.look!;
  const placed = look.view.nodes.map((n) => `${n.x},${n.y}`).join(" ");
  useEffect(() => {
    let gone = false;
    store.transport
      .ask<Scene>("schematic", { level: look.view.path })
      .then((a) => {
        if (gone) return;
        setScene(a);
        setWhy("");
      })
      .catch((e) => {
        if (gone) return;
        setScene(null);
        setWhy(e instanceof Refused ? `${e.problem.why}. ${e.problem.try ?? ""}` : String(e));
      });
    return () => {
      gone = true;
    };
  }, [look.revision, look.view.path, placed]);
  const bondOf = (key: string) => look.view.bonds.find((b) => `${b.ends[0]} -> ${b.ends[1]}` === key)?.key;
  const chosen = (name: string, key: string) => (name === "wire" ? state.bonds.has(bondOf(key) ?? "") : state.nodes.has(key));
  const drawn = state.cursor?.strokes ?? look.strokes;
  const bondOff = (key: string, ends: string[]) => (drawn.bonds[key] ?? drawn.bonds[`${ends[0]} -> ${ends[1]}`])?.off;
  /** Whether it is OFF in the mode that is shown: a bond, a junction, a part; or all its bonds are. */
  const off = (name: string, key: string) => {
    if (name === "wire") return look.view.bonds.some((b) => `${b.ends[0]} -> ${b.ends[1]}` === key && bondOff(b.key, b.ends));
    const own = look.view.bonds.filter((b) => b.tail === key || b.head === key);
    return drawn.nodes[key]?.off || (own.length > 0 && own.every((b) => bondOff(b.key, b.ends)));
  };
  const select = (e: MouseEvent, name: string, key: string) => {
    const add = e.shiftKey || e.ctrlKey || e.metaKey;
    const tab = state.tab === "power" ? state.tab : "item";
    if (name === "wire") {
      const bond = bondOf(key);
      if (bond) store.set({ bonds: new Set(add ? [...state.bonds, bond] : [bond]), nodes: add ? state.nodes : new Set(), tab });
    } else if (key) store.set({ nodes: new Set(add ? [...state.nodes, key] : [key]), bonds: add ? state.bonds : new Set(), tab });
  };
  const open = (name: string, key: string) => {
    const node = look.view.nodes.find((n) => n.name === key);
    if (name === "part" && node?.kind === "part" && node.known) store.open(state.level ? `${state.level}.${key}` : key);
  };
  return (
    <section class="schematic" aria-label="Schematic">
      {why && <p class="hint">{why}</p>}
      {scene && (
        <svg viewBox={`0 0 ${scene.width} ${scene.height}`} style={{ maxWidth: `${scene.width * 1.6}px` }} role="img" aria-label={`Schematic: ${scene.groups.filter((g) => g.name === "part").map((g) => g.key).join(", ")}`}>
          {scene.groups.map((g) => (
            <g
              class={g.name + (chosen(g.name, g.key) ? " selected" : "") + (off(g.name, g.key) ? " off" : "")}
              data-schematic={g.key}
              onClick={(e) => select(e, g.name, g.key)}
              onDblClick={() => open(g.name, g.key)}
            >
              {g.about && <title>{g.about}</title>}
              {g.marks.map((m) =>
                m.d !== undefined ? (
                  <>
                    <path class="reach" d={m.d} />
                    <path class={m.role} d={m.d} />
                  </>
                ) : (
                  <text class={m.role} x={m.x} y={m.y} text-anchor={m.anchor}>
                    {m.text}
                  </text>
                ),
              )}
            </g>
          ))}
        </svg>
      )}
    </section>
  );
}
