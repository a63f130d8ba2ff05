/** A text that is written when one leaves it or presses Enter. */
import { useEffect, useRef, useState } from "preact/hooks";

interface FieldProps {
  value: string;
  onWrite: (text: string) => void;
  label: string;
  first?: boolean;
  disabled?: boolean;
  list?: string[];
  placeholder?: string;
}

let count = 0;

export function Field(p: FieldProps) {
  const [text, setText] = useState(p.value);
  const [id] = useState(() => `list${++count}`);
  const focused = useRef(false);
  useEffect(() => {
    if (!focused.current) setText(p.value);
  }, [p.value]);
  const write = () => {
    focused.current = false;
    if (text !== p.value) p.onWrite(text);
  };
  return (
    <>
      <input
        aria-label={p.label}
        value={text}
        disabled={p.disabled}
        placeholder={p.placeholder}
        spellcheck={false}
        autocomplete="off"
        list={p.list ? id : undefined}
        data-first={p.first ? "" : undefined}
        onFocus={() => (focused.current = true)}
        onInput={(e) => setText(e.currentTarget.value)}
        onBlur={write}
        onKeyDown={(e) => {
          if (e.key === "Enter") e.currentTarget.blur();
          if (e.key === "Escape") {
            setText(p.value);
            focused.current = false;
            requestAnimationFrame(() => document.querySelector<SVGSVGElement>(".canvas svg")?.focus());
          }
          e.stopPropagation();
        }}
      />
      {p.list && (
        <datalist id={id}>
          {p.list.map((word) => (
            <option value={word} />
          ))}
        </datalist>
      )}
    </>
  );
}

/** What is written as a number where it is one, so that a file says 2 and not "2". */
export function valueOf(text: string): string | number | null {
  const bare = text.trim();
  if (bare === "") return null;
  return /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i.test(bare) ? Number(bare) : bare;
}
