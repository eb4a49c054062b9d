// A value that tells those who asked when it changes.

export class Signal<T> {
  private listeners: ((value: T) => void)[] = [];

  constructor(private current: T) {}

  get value(): T {
    return this.current;
  }

  set(value: T): void {
    if (value === this.current) return;
    this.current = value;
    this.emit();
  }

  /// Tells everyone though the value is the same object, because its content changed.
  emit(): void {
    for (const listener of this.listeners) listener(this.current);
  }

  /// Calls now and on every change.
  watch(listener: (value: T) => void): void {
    this.listeners.push(listener);
    listener(this.current);
  }
}
