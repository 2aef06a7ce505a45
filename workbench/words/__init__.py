"""Words: numbers, units and labels as text, and the sentences about outcomes, cautions, branches and pipes."""
