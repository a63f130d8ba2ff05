/** Questions and answers over any carrier: a WebSocket, or the messages of a notebook widget. */
import type { Problem } from "./messages";

export type Message = Record<string, unknown>;

export class Refused extends Error {
  constructor(readonly problem: Problem) {
    super(problem.why);
  }
}

export interface Carrier {
  send(text: Message): void;
}

export class Transport {
  private count = 0;
  private waiting = new Map<number, { done: (m: any) => void; failed: (e: Error) => void }>();
  private held: Message[] = [];
  carrier: Carrier | null = null;
  onTold: (message: Message) => void = () => {};
  readonly client = Math.random().toString(36).slice(2, 10);

  ask<T>(ask: string, more: object = {}): Promise<T> {
    const id = ++this.count;
    const message = { ...more, id, ask, client: this.client };
    return new Promise<T>((done, failed) => {
      this.waiting.set(id, { done, failed });
      if (this.carrier) this.carrier.send(message);
      else this.held.push(message);
    });
  }

  /** A carrier is there, again perhaps: what was asked meanwhile is sent. */
  connected(carrier: Carrier): void {
    this.carrier = carrier;
    const held = this.held;
    this.held = [];
    for (const message of held) carrier.send(message);
  }

  lost(): void {
    this.carrier = null;
    for (const { failed } of this.waiting.values()) failed(new Error("the studio was left"));
    this.waiting.clear();
  }

  received(message: Message): void {
    if (typeof message.id === "number") {
      const asked = this.waiting.get(message.id);
      this.waiting.delete(message.id);
      if (!asked) return;
      if (message.error) asked.failed(new Refused(message.error as Problem));
      else asked.done(message);
    } else this.onTold(message);
  }
}

/** Talk over a WebSocket, and come back when it was cut. */
export function overSocket(transport: Transport, onState: (connected: boolean) => void): void {
  const token = new URLSearchParams(location.search).get("token") ?? "";
  let wait = 250;
  const open = () => {
    const socket = new WebSocket(
      `ws://${location.host}/talk?token=${encodeURIComponent(token)}`,
    );
    socket.onopen = () => {
      wait = 250;
      transport.connected({ send: (m) => socket.send(JSON.stringify(m)) });
      onState(true);
    };
    socket.onmessage = (e) => transport.received(JSON.parse(e.data as string));
    socket.onclose = () => {
      transport.lost();
      onState(false);
      setTimeout(open, wait);
      wait = Math.min(4000, wait * 2);
    };
  };
  open();
}
