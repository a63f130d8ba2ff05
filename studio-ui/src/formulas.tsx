/** Formulas as the session sets them: trees of MathML; what modes are like; equations as text. */
import { h, type VNode } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Formula, Written } from "./messages";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

const TAGS = new Set(
  "math mrow mi mo mn mtext mspace mfrac msub msup msubsup mover munder munderover msqrt mroot mtable mtr mtd mstyle".split(" "),
);

function set(part: Formula | string): VNode | string {
  if (typeof part === "string") return part;
  const [tag, attributes, ...inside] = part;
  const outer = tag === "math" ? { display: "block" } : {};
  return h(TAGS.has(tag) ? tag : "mrow", { ...attributes, ...outer }, ...inside.map(set));
}

type Choice = "all" | "mode" | "structure";

export function Equations({ store, state }: Props) {
  const [choice, choose] = useState<Choice>("all");
  const [plain, setPlain] = useState(false);
  const [found, setFound] = useState<Written | null>(null);
  const look = state.look!;
  const mode = state.cursor?.mode ?? Object.fromEntries(look.machines.map((m) => [m.path, m.state]));
  const shown = choice === "mode" ? JSON.stringify(mode) : "";
  useEffect(() => {
    let gone = false;
    setFound(null);
    store.transport
      .ask<Written>(choice === "structure" ? "structure" : "equations", { one: choice === "mode", mode })
      .then((a) => !gone && setFound(a))
      .catch((e) => !gone && setFound({ text: String(e.message) }));
    return () => {
      gone = true;
    };
  }, [look.revision, choice, shown]);
  const choices: [Choice, string][] = [
    ["all", "all modes"],
    ["mode", "the mode drawn"],
    ["structure", "structure"],
  ];
  return (
    <section class="formulas">
      <div class="row">
        {choices.map(([key, word]) => (
          <button aria-pressed={choice === key} onClick={() => choose(key)}>
            {word}
          </button>
        ))}
        {found?.formula && (
          <label>
            <input type="checkbox" checked={plain} onChange={(e) => setPlain(e.currentTarget.checked)} /> as text
          </label>
        )}
      </div>
      {!found && <p class="hint">…</p>}
      {found?.formula && !plain ? (
        <div class="formula" tabindex={0} role="group" aria-label="Equations">
          {set(found.formula)}
        </div>
      ) : (
        found && (
          <pre class="equations" tabindex={0}>
            {found.text}
          </pre>
        )
      )}
      {found?.notes?.map((note) => <p class="hint">{note}</p>)}
    </section>
  );
}
