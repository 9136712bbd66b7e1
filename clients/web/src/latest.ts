// Runs one task at a time. The next task takes the newest input; older inputs are dropped.

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
