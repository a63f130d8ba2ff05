/** What two answers have in common stays the same object: what has not changed is not drawn anew. */
export function shared<T>(old: unknown, now: T): T {
  if (old === now || typeof now !== "object" || now === null) return now;
  if (typeof old !== "object" || old === null || Array.isArray(old) !== Array.isArray(now)) return now;
  const [a, b] = [old as Record<string, unknown>, now as Record<string, unknown>];
  const keys = Object.keys(b);
  let same = keys.length === Object.keys(a).length;
  for (const key of keys) {
    const value = shared(a[key], b[key]);
    b[key] = value;
    same &&= value === a[key] && key in a;
  }
  return same ? (old as T) : now;
}
