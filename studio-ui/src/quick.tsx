/** A line to write in, and what fits it: chosen by arrows, taken by Enter or a click. */
import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";

interface Props<T> {
  title: string;
  ask: string;
  placeholder: string;
  /** So many of what fits are shown. */
  most: number;
  fitting: (text: string) => T[];
  say: (found: T) => ComponentChildren;
  none?: string;
  /** Do what is chosen; false: there was nothing to do. */
  take: (found: T | undefined, text: string) => boolean | Promise<boolean>;
  close: () => void;
}

export function Quick<T>({ title, ask, placeholder, most, fitting, say, none, take, close }: Props<T>) {
  const [text, setText] = useState("");
  const [chosen, choose] = useState(0);
  const found = fitting(text);
  const last = Math.min(found.length, most) - 1;
  const leave = () => {
    document.querySelector<SVGSVGElement>(".canvas svg")?.focus();
    close();
  };
  const go = async (one: T | undefined) => {
    if (await take(one, text)) leave();
  };
  return (
    <div class="quick" role="dialog" aria-label={title}>
      <input
        ref={(input) => input?.focus()}
        value={text}
        aria-label={ask}
        placeholder={placeholder}
        onInput={(e) => {
          setText(e.currentTarget.value);
          choose(0);
        }}
        onKeyDown={(e) => {
          const step = { ArrowDown: 1, ArrowUp: -1 }[e.key];
          if (step) {
            choose(Math.max(0, Math.min(chosen + step, last)));
            e.preventDefault();
          }
          if (e.key === "Enter") void go(found[Math.min(chosen, last)]);
          if (e.key === "Escape") leave();
          e.stopPropagation();
        }}
      />
      <ul>
        {found.slice(0, most).map((one, k) => (
          <li class={k === chosen ? "chosen" : ""} onClick={() => void go(one)}>
            {say(one)}
          </li>
        ))}
        {found.length > most && <li>{found.length - most} more</li>}
        {none && text.trim() && !found.length && <li>{none}</li>}
      </ul>
    </div>
  );
}
