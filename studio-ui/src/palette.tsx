/** The palette: kinds of element and ready parts, put down by a click or by dragging. */
import { useState } from "preact/hooks";
import { Quick } from "./quick";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

interface Offer {
  key: string;
  letters: string;
  about: string;
  element: object;
  stem: string;
}

function offers(state: State): { kinds: Offer[]; parts: Map<string, Offer[]> } {
  const stock = state.stock;
  const kinds = (stock?.kinds ?? []).map((k) => ({
    key: k.kind,
    letters: k.kind === "G" ? "G" : k.letters,
    about: k.about,
    element: k.element,
    stem: k.stem,
  }));
  const parts = new Map<string, Offer[]>();
  for (const p of stock?.parts ?? []) {
    const [domain, name] = p.name.split(".");
    const offer = { key: p.name, letters: name, about: p.title, element: { submodel: p.name }, stem: name };
    parts.set(domain, [...(parts.get(domain) ?? []), offer]);
  }
  return { kinds, parts };
}

export function Palette({ store, state }: Props) {
  const [search, setSearch] = useState("");
  const { kinds, parts } = offers(state);
  const domain = state.look?.view.domain ?? "";
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const fits = (o: Offer) => words.every((w) => `${o.key} ${o.about}`.toLowerCase().includes(w));
  const shelves = [...parts].sort(([a], [b]) => Number(b === domain) - Number(a === domain));
  const drag = (o: Offer) => (e: DragEvent) =>
    e.dataTransfer!.setData("application/x-hybond", JSON.stringify({ element: o.element, stem: o.stem }));
  const put = (o: Offer) => {
    void store.add(o.element, o.stem);
    store.set({ panel: "" });
  };
  const disabled = !state.look?.view.editable;
  return (
    <aside class={"palette" + (state.panel === "palette" ? " open" : "")} aria-label="Palette">
      <div class="kinds">
        {kinds.map((o) => (
          <button disabled={disabled} draggable onDragStart={drag(o)} onClick={() => put(o)} title={o.about} aria-label={`Add ${o.key}, ${o.about}`} data-kind={o.key}>
            {o.letters}
          </button>
        ))}
      </div>
      <input type="search" placeholder="Parts …" aria-label="Search parts" value={search} onInput={(e) => setSearch(e.currentTarget.value)} />
      <div class="shelves" tabindex={0} role="region" aria-label="Ready parts">
        {shelves.map(([shelf, offered]) => {
          const found = offered.filter(fits);
          if (!found.length) return null;
          return (
            <details open={words.length > 0 || shelf === domain}>
              <summary>
                {shelf} <small>{found.length}</small>
              </summary>
              {found.map((o) => (
                <button class="offer" disabled={disabled} draggable onDragStart={drag(o)} onClick={() => put(o)} title={o.about} data-part={o.key}>
                  {o.letters.replaceAll("_", " ")}
                </button>
              ))}
            </details>
          );
        })}
      </div>
    </aside>
  );
}

const NAME = /^[A-Za-z_]\w*$/;
const SHOWN = 8;
const NOWHERE = 5;

/** How well a part is what is written: its name itself, how that begins, a part of it, what is said of it. */
function rankOf(o: Offer, sought: string): number {
  const name = o.letters.replaceAll("_", " ").toLowerCase();
  const words = sought.replaceAll("_", " ");
  if (name === words || o.key === sought) return 0;
  if (name.startsWith(words)) return 1;
  if (` ${name}`.includes(` ${words}`)) return 2;
  if (`${o.key} ${name}`.includes(words)) return 3;
  return o.about.toLowerCase().includes(words) ? 4 : NOWHERE;
}

/** The domain of the part that is selected, or was put down last; else that of the model. */
function shelfOf(state: State): string {
  const nodes = state.look?.view.nodes ?? [];
  const parts = nodes.filter((n) => String(n.entry.submodel ?? "").includes("."));
  const part = parts.find((n) => state.nodes.has(n.name)) ?? parts[parts.length - 1];
  return part ? String(part.entry.submodel).split(".")[0] : (state.look?.view.domain ?? "");
}

/** What is written for a new element: the offers that fit, and the words behind the first. */
function read(state: State, text: string) {
  const { kinds, parts } = offers(state);
  const all = [...kinds, ...[...parts.values()].flat()];
  const [head, ...rest] = text.trim().split(/\s+/);
  const exact = kinds.find((o) => o.key === head);
  // a part, too, may be given a name: "inertia flywheel"
  const called = !exact && rest.length === 1 && NAME.test(rest[0]) && all.some((o) => o.letters === head);
  const sought = (called ? head : text.trim()).toLowerCase();
  const shelf = shelfOf(state);
  const found = text.includes("->")
    ? []
    : exact
      ? [exact, ...all.filter((o) => o !== exact && o.key.includes(head))]
      : all
          .map((o) => ({ o, rank: 2 * rankOf(o, sought) - Number(o.key.startsWith(`${shelf}.`)) }))
          .filter(({ rank }) => rank < 2 * NOWHERE - 1)
          .sort((a, b) => a.rank - b.rank)
          .map(({ o }) => o);
  return { exact, called, rest, found };
}

/** Add by writing: "I", "R load 10 ohm", "diode", "v -> m". */
export function QuickAdd({ store, state }: Props) {
  const put = async (offer: Offer | undefined, text: string) => {
    if (text.includes("->")) {
      await store.edit({ do: "write bond", text: text.trim() });
      return true;
    }
    if (!offer) return false;
    const { exact, called, rest } = read(state, text);
    let element = offer.element as Record<string, unknown>;
    let name = "";
    if (offer.key === exact?.key) {
      // a name is a word that is none of a value: "R load 10 ohm"
      if (rest.length && NAME.test(rest[0])) name = rest.shift()!;
      const value = rest.join(" ");
      if (value && !("junction" in element)) element = { [offer.key]: value };
    } else if (called) name = rest[0];
    await store.add(element, name || offer.stem);
    return true;
  };
  return (
    <Quick
      title="Add"
      ask="What to add"
      placeholder="R load 10 ohm · diode · a -> b"
      most={SHOWN}
      fitting={(text) => read(state, text).found}
      say={(o) => (
        <>
          <b>{o.letters}</b> {o.about}
          {o.key.includes(".") && <small> {o.key.split(".")[0]}</small>}
        </>
      )}
      take={put}
      close={() => store.set({ adding: false })}
    />
  );
}
