/** The palette: kinds of element and ready parts, put down by a click or by dragging. */
import { useState } from "preact/hooks";
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

/** Add by writing: "I", "R load 10 ohm", "diode", "v -> m". */
export function QuickAdd({ store, state }: Props) {
  const [text, setText] = useState("");
  const { kinds, parts } = offers(state);
  const all = [...kinds, ...[...parts.values()].flat()];
  const [head, ...rest] = text.trim().split(/\s+/);
  const exact = kinds.find((o) => o.key === head);
  const found = text.includes("->")
    ? []
    : exact
      ? [exact, ...all.filter((o) => o !== exact && o.key.includes(head))]
      : all.filter((o) => `${o.key} ${o.about}`.toLowerCase().includes(text.trim().toLowerCase()));
  const close = () => {
    document.querySelector<SVGSVGElement>(".canvas svg")?.focus();
    store.set({ adding: false });
  };
  const put = async () => {
    if (text.includes("->")) {
      await store.edit({ do: "write bond", text: text.trim() });
      return close();
    }
    const offer = found[0];
    if (!offer) return;
    let element = offer.element as Record<string, unknown>;
    let name = "";
    if (offer === exact && rest.length) {
      // a name is a word that is none of a value: "R load 10 ohm"
      if (/^[A-Za-z_]\w*$/.test(rest[0])) name = rest.shift()!;
      const value = rest.join(" ");
      if (value && !("junction" in element)) element = { [offer.key]: value };
    }
    await store.add(element, name || offer.stem);
    close();
  };
  return (
    <div class="quick" role="dialog" aria-label="Add">
      <input
        ref={(input) => input?.focus()}
        value={text}
        aria-label="What to add"
        placeholder="R load 10 ohm · diode · a -> b"
        onInput={(e) => setText(e.currentTarget.value)}
        onKeyDown={(e) => {
          if (e.key === "Enter") void put();
          if (e.key === "Escape") close();
          e.stopPropagation();
        }}
      />
      <ul>
        {found.slice(0, 8).map((o, k) => (
          <li class={k === 0 ? "chosen" : ""}>
            <b>{o.letters}</b> {o.about}
          </li>
        ))}
      </ul>
    </div>
  );
}
