// How many answers a second came while something was dragged.

const SPAN = 2000; /* milliseconds that are looked back on */

export class Rate {
  private times: number[] = [];

  count(): void {
    const now = performance.now();
    this.times.push(now);
    this.times = this.times.filter((time) => time > now - SPAN);
  }

  /** Of the last two seconds that had answers. */
  get perSecond(): number {
    const { times } = this;
    if (times.length < 2) return 0;
    return ((times.length - 1) * 1000) / (times.at(-1)! - times[0]!);
  }
}
