// What a scenario found: lines to print, figures to keep, and what must hold.

export class Outcome {
  constructor(name) {
    this.name = name;
    this.failures = [];
    /** Figures that the docs show and that must not get worse: { name, value, better }. */
    this.figures = [];
  }

  say(text) {
    console.log(`  ${text}`);
  }

  /** What must hold; `text` says it as it should be. */
  check(holds, text) {
    if (holds) return;
    this.failures.push(text);
    console.log(`  FAILED: ${text}`);
  }

  /** A figure, of which the lower is the better, unless it is said to be the other way. */
  figure(name, value, better = 'lower') {
    this.figures.push({ name, value: Number(value.toPrecision(6)), better });
  }
}
