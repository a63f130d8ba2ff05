/** A guard or a law as text: names are completed at the caret, and what is wrong is told as one types. */
import { useEffect, useRef, useState } from "preact/hooks";
import type { Problem } from "./messages";

interface Props {
  value: string;
  label: string;
  disabled?: boolean;
  words: string[];
  onWrite: (text: string) => void;
  /** What would be wrong with a text, null if nothing. */
  check: (text: string) => Promise<Problem | null>;
  /** What is wrong with the text that is written, if that is known. */
  told?: Problem | null;
  placeholder?: string;
}

const PATIENCE = 250;
const WORD = /[A-Za-z_][\w.]*$/;
let count = 0;

export function ExpressionField(p: Props) {
  const [text, setText] = useState(p.value);
  const [offers, setOffers] = useState<string[]>([]);
  const [chosen, choose] = useState(-1);
  const [wrong, setWrong] = useState<Problem | null>(null);
  const [id] = useState(() => `words${++count}`);
  const input = useRef<HTMLInputElement>(null);
  const focused = useRef(false);
  const asked = useRef(0);
  useEffect(() => {
    if (!focused.current) setText(p.value);
    setWrong(null);
  }, [p.value]);
  const close = () => {
    setOffers([]);
    choose(-1);
  };
  const typed = () => {
    const now = input.current!.value;
    setText(now);
    const head = WORD.exec(now.slice(0, input.current!.selectionStart ?? now.length))?.[0] ?? "";
    const low = head.toLowerCase();
    const fits = head ? p.words.filter((w) => w !== head && w.toLowerCase().includes(low)) : [];
    fits.sort((a, b) => Number(b.toLowerCase().startsWith(low)) - Number(a.toLowerCase().startsWith(low)));
    setOffers(fits.slice(0, 8));
    choose(-1);
    const number = ++asked.current;
    setTimeout(() => {
      if (number !== asked.current) return;
      p.check(now).then((problem) => number === asked.current && setWrong(problem)).catch(() => {});
    }, PATIENCE);
  };
  const take = (word: string) => {
    const field = input.current!;
    const caret = field.selectionStart ?? field.value.length;
    const head = field.value.slice(0, caret).replace(WORD, word);
    field.value = head + field.value.slice(caret);
    field.setSelectionRange(head.length, head.length);
    close();
    typed();
    setOffers([]);
    field.focus();
  };
  const write = () => {
    focused.current = false;
    asked.current++;
    close();
    if (text !== p.value) p.onWrite(text);
  };
  const key = (e: KeyboardEvent) => {
    e.stopPropagation();
    const way = { ArrowDown: 1, ArrowUp: -1 }[e.key];
    if (way && offers.length) {
      e.preventDefault();
      choose((chosen + way + offers.length) % offers.length);
    } else if ((e.key === "Tab" || e.key === "Enter") && chosen >= 0) {
      e.preventDefault();
      take(offers[chosen]);
    } else if (e.key === "Enter") input.current!.blur();
    else if (e.key === "Escape") {
      if (offers.length) return close();
      setText(p.value);
      setWrong(null);
      focused.current = false;
      requestAnimationFrame(() => document.querySelector<SVGSVGElement>(".canvas svg")?.focus());
    }
  };
  const said = wrong ?? (text === p.value ? (p.told ?? null) : null);
  return (
    <span class="expression">
      <input
        ref={input}
        aria-label={p.label}
        value={text}
        disabled={p.disabled}
        placeholder={p.placeholder}
        spellcheck={false}
        autocomplete="off"
        role="combobox"
        aria-autocomplete="list"
        aria-expanded={offers.length > 0}
        aria-controls={id}
        aria-activedescendant={chosen >= 0 ? `${id}-${chosen}` : undefined}
        aria-invalid={!!said}
        aria-describedby={said ? `${id}-wrong` : undefined}
        onFocus={() => (focused.current = true)}
        onInput={typed}
        onBlur={write}
        onKeyDown={key}
      />
      {offers.length > 0 && (
        <ul id={id} role="listbox" aria-label="Names">
          {offers.map((word, k) => (
            <li
              id={`${id}-${k}`}
              role="option"
              aria-selected={k === chosen}
              onMouseDown={(e) => {
                e.preventDefault();
                take(word);
              }}
            >
              {word}
            </li>
          ))}
        </ul>
      )}
      {said && (
        <small class="wrong" id={`${id}-wrong`} role="status">
          {said.why} {said.try && <em>{said.try}</em>}
        </small>
      )}
    </span>
  );
}
