// What the service says where it refuses.

/** Its problem detail (RFC 9457) in words; of an answer that has none, the status. */
export async function reason(response: Response): Promise<string> {
  try {
    const problem = (await response.json()) as { detail?: string; errors?: { field: string; message: string }[] };
    const fields = (problem.errors ?? []).map((one) => `${one.field}: ${one.message}`);
    return [problem.detail ?? response.statusText, ...fields].join("\n");
  } catch {
    return `${response.status} ${response.statusText}`;
  }
}
