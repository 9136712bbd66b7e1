// Work of which only the newest matters: one at a time, and what was asked for meanwhile is done next, the last of it
// only.

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
