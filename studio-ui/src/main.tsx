/** The page in the browser. */
import { render } from "preact";
import { App } from "./app";
import { Store } from "./store";
import "./style.css";
import { Transport, overSocket } from "./transport";

const transport = new Transport();
const store = new Store(transport);
overSocket(transport, (connected) => (connected ? void store.begin() : store.set({ connected })));
render(<App store={store} />, document.getElementById("studio")!);
