"""When it switches: settling, jumps, locating events, accumulation, sliding, the audit."""
