// Problem details (RFC 9457) of a response that is an error.

/** The detail and the errors of fields; the status where the response has none. */
export async function problemText(response: Response): Promise<string> {
  try {
    const problem = (await response.json()) as { detail?: string; errors?: { field: string; message: string }[] };
    const fields = (problem.errors ?? []).map((one) => `${one.field}: ${one.message}`);
    return [problem.detail ?? response.statusText, ...fields].join("\n");
  } catch {
    return `${response.status} ${response.statusText}`;
  }
}
