#pragma once

/// Makes Ctrl-C (SIGINT), SIGTERM and the closing of the terminal (SIGHUP) a request that long work looks at,
/// rather than the end. A second Ctrl-C or SIGTERM ends at once.
void catch_interrupts();

/// Whether there was one.
bool interrupted();
