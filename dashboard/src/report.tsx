export function Report({ id }: { id: string }) { return <p>{id}</p>; }
