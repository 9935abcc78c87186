// Threads that compute. One answers a question at a time; a new question takes the place of an old one that waits.
import { textOf } from "./state.js";

/** How long, in milliseconds, an answer that nobody wants any more may still take. */
const PATIENCE = 400;

const decode = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));

let compiled = null;

/** The model, compiled once for all threads. */
function model() {
  compiled ??= WebAssembly.compile(decode(document.getElementById("model").textContent));
  return compiled;
}

/** Thrown where a newer question has taken the place of this one. */
export class Superseded extends Error {}

export class Engine {
  /** A thread that may take `limit` milliseconds for an answer or a part of it. */
  constructor(limit) {
    this.limit = limit;
    this.worker = null;
    this.asked = null;
    this.waiting = null;
    this.count = 0;
    // Numbers of the files that the thread has.
    this.sent = new Set();
  }

  async start() {
    const text = document.getElementById("worker").textContent;
    const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
    const worker = new Worker(address);
    URL.revokeObjectURL(address);
    worker.onmessage = ({ data }) => this.hear(data);
    worker.onerror = (event) => {
      this.kill();
      this.fail(`the model could not start: ${event.message}`);
    };
    worker.postMessage({ module: await model() });
    return worker;
  }

  /** Asks; `each` gets the parts of the answer. Resolves with the last part. */
  ask(question, each = () => {}) {
    return new Promise((resolve, reject) => {
      this.waiting?.reject(new Superseded());
      this.waiting = { question, each, resolve, reject };
      if (this.asked?.question.job === "live") this.hurry(this.asked);
      else this.stop();
      this.go();
    });
  }

  /** Ends what goes on soon: most answers come before that. */
  hurry(asked) {
    asked.hurry ??= setTimeout(() => {
      if (this.asked !== asked || !this.waiting) return;
      this.stop();
      this.go();
    }, PATIENCE);
  }

  /** Ends what goes on; its thread is lost. */
  stop() {
    if (!this.asked) return;
    this.asked.reject(new Superseded());
    this.end();
    this.kill();
  }

  kill() {
    this.worker?.then((worker) => worker.terminate(), () => {});
    this.worker = null;
    this.sent.clear();
  }

  end() {
    clearTimeout(this.timer);
    clearTimeout(this.asked?.hurry);
    this.asked = null;
  }

  async go() {
    if (this.asked || !this.waiting) return;
    const asked = this.waiting;
    this.asked = asked;
    this.waiting = null;
    asked.id = ++this.count;
    this.watch();
    this.worker ??= this.start();
    try {
      const worker = await this.worker;
      if (this.asked !== asked) return;
      const missing = Object.values(asked.question.machine.files).filter((id) => !this.sent.has(id));
      missing.forEach((id) => this.sent.add(id));
      worker.postMessage({ id: asked.id, ...asked.question, texts: missing.map((id) => [id, textOf(id)]) });
    } catch (error) {
      if (this.asked !== asked) return;
      this.kill();
      this.fail(`the model could not start: ${error.message}`);
    }
  }

  watch() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      this.kill();
      this.fail(`this takes more than ${this.limit / 1000} s: too many impacts, or too long a run`);
    }, this.limit);
  }

  hear({ id, part, done, error, isFault }) {
    if (this.asked?.id !== id) return;
    if (error !== undefined) {
      if (isFault) this.kill();
      this.fail(error);
    } else if (done) {
      const { resolve, last } = this.asked;
      this.end();
      resolve(last);
      this.go();
    } else {
      this.watch();
      this.asked.last = part;
      this.asked.each(part);
    }
  }

  fail(reason) {
    const asked = this.asked;
    this.end();
    asked?.reject(new Error(reason));
    this.go();
  }
}
