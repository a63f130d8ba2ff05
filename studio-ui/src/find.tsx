/** To an element or a bond by its name: "/" and some letters of it. */
import { Quick } from "./quick";
import type { State, Store } from "./store";

const SHOWN = 10;

interface Props {
  store: Store;
  state: State;
}

interface Found {
  key: string;
  said: string;
  about: string;
  bond: boolean;
}

/** Letters as they are typed: a capacitor of 2 µF is looked for by "2 uF", 10 Ω by "10 ohm". */
const typed = (text: string) => text.toLowerCase().replaceAll(/[µμ]/g, "u").replaceAll(/[Ωω]/g, "ohm");

/** What is called so: names that are it, that begin with it, that have it; then bonds and values. */
function search(state: State, words: string): Found[] {
  const view = state.look?.view;
  if (!view || !words) return [];
  const rank = (name: string, about: string) =>
    name === words ? 0 : name.startsWith(words) ? 1 : name.includes(words) ? 2 : about.includes(words) ? 4 : 9;
  const nodes = view.nodes.map((n) => {
    const about = n.kind === "part" ? String(n.entry.submodel ?? "") : [n.letters, n.says].filter(Boolean).join(" ");
    return { key: n.name, said: n.name, about, bond: false, rank: rank(n.name.toLowerCase(), typed(about)) };
  });
  const bonds = view.bonds.map((b) => ({
    key: b.key,
    said: b.text,
    about: "bond",
    bond: true,
    rank: b.text.toLowerCase().includes(words) ? 3 : 9,
  }));
  return [...nodes, ...bonds].filter((f) => f.rank < 9).sort((a, b) => a.rank - b.rank);
}

export function Find({ store, state }: Props) {
  const go = (f: Found | undefined) => {
    if (f) store.set({ nodes: new Set(f.bond ? [] : [f.key]), bonds: new Set(f.bond ? [f.key] : []), tab: "item" });
    return f !== undefined;
  };
  return (
    <Quick
      title="Find"
      ask="What to find"
      placeholder="a name, a kind, a value"
      most={SHOWN}
      fitting={(text) => search(state, typed(text.trim()))}
      say={(f) => (
        <>
          <b>{f.said}</b> {f.about}
        </>
      )}
      none="nothing of that name at this level"
      take={go}
      close={() => store.set({ finding: false })}
    />
  );
}
