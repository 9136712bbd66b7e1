// Measures the answers per second during a drag.

const SPAN = 2000; /* milliseconds before the last answer that count */

export class Rate {
  private times: number[] = [];

  count(): void {
    const now = performance.now();
    this.times.push(now);
    this.times = this.times.filter((time) => time > now - SPAN);
  }

  /** Answers per second in the last SPAN before the last answer. */
  get perSecond(): number {
    const { times } = this;
    if (times.length < 2) return 0;
    return ((times.length - 1) * 1000) / (times.at(-1)! - times[0]!);
  }
}
