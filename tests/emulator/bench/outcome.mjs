// Outcome of a scenario: lines to print, figures to keep, goals, and checks.

export class Outcome {
  constructor(name) {
    this.name = name;
    this.failures = [];
    /** Figures that the docs show: { name, value, better, inDocs, goal }. `better` is 'lower', 'higher' or 'neither'. */
    this.figures = [];
    /** Goals, met and missed: { name, met }. */
    this.goals = [];
  }

  say(text) {
    console.log(`  ${text}`);
  }

  /** Checks a condition; `text` describes the expected result. */
  check(holds, text) {
    if (holds) return;
    this.failures.push(text);
    console.log(`  FAILED: ${text}`);
  }

  /**
   * A figure that must not get worse. `better`: 'lower', 'higher', or 'neither' for one that may change. With `inDocs` false it
   * is in docs/emulated.csv only.
   */
  figure(name, value, better = 'lower', { inDocs = true } = {}) {
    this.figures.push({ name, value: Number(value.toPrecision(6)), better, inDocs });
  }

  /** A figure with a goal: at most `max`. If the goal is `enforced`, the scenario fails when it is missed. */
  goal(name, value, { max, enforced }) {
    // An enforced goal is its bound. A few cycles more or less within it are those of a build.
    this.figure(name, value, enforced ? 'neither' : 'lower');
    this.figures[this.figures.length - 1].goal = max;
    this.reach(value <= max, `${name}: ${grouped(value)}, goal at most ${grouped(max)}`, enforced);
  }

  /** A goal without a figure: `text` describes the result. */
  reach(met, text, enforced = false) {
    this.goals.push({ name: text, met });
    if (met || !enforced) console.log(`  goal ${met ? 'met' : 'MISSED'}: ${text}`);
    else this.check(false, `goal missed: ${text}`);
  }
}

const grouped = (value) => value.toLocaleString('en-US', { maximumFractionDigits: 1 });
