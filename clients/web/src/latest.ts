// Runs one task at a time, and measures the answers per second during a drag.

/** Runs one task at a time. The next task uses the newest input, and older inputs are dropped. */
export class Latest<T> {
  private next: T | undefined;
  private running = false;

  constructor(private readonly work: (input: T) => Promise<void>) {}

  get busy(): boolean {
    return this.running;
  }

  put(input: T): void {
    this.next = input;
    if (!this.running) void this.run();
  }

  /** Drops the input that waits for the running task. */
  drop(): void {
    this.next = undefined;
  }

  private async run(): Promise<void> {
    this.running = true;
    while (this.next !== undefined) {
      const input = this.next;
      this.next = undefined;
      await this.work(input);
    }
    this.running = false;
  }
}

const SPAN = 2000; /* milliseconds; earlier answers do not count */

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
