// What a scenario found: figures to print and to keep, and what must hold.

export class Outcome {
  constructor(name) {
    this.name = name;
    this.failures = [];
    this.lines = [];
    /** Figures that the docs show and that must not get worse: name to number. */
    this.figures = new Map();
  }

  say(text) {
    this.lines.push(text);
    console.log(`  ${text}`);
  }

  /** What must hold; `text` says it as it should be. */
  check(holds, text) {
    if (holds) return;
    this.failures.push(text);
    console.log(`  FAILED: ${text}`);
  }

  figure(name, value) {
    this.figures.set(name, value);
  }
}
