/** The page in a notebook: messages go through the widget's model. */
import { render as draw } from "preact";
import { App } from "./app";
import { Store } from "./store";
import "./style.css";
import "./sweep.css";
import { Transport, type Message } from "./transport";

interface Model {
  get(name: string): unknown;
  send(message: Message): void;
  on(name: string, listener: (message: Message) => void): void;
  off(name: string, listener: (message: Message) => void): void;
}

export function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  const transport = new Transport();
  const store = new Store(transport);
  const received = (message: Message) => transport.received(message);
  model.on("msg:custom", received);
  transport.connected({ send: (m) => model.send(m) });
  el.style.height = `${model.get("height")}px`;
  el.classList.add("hybond-widget");
  draw(<App store={store} />, el);
  void store.begin();
  return () => {
    model.off("msg:custom", received);
    draw(null, el);
  };
}

export default { render };
