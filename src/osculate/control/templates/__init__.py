"""Templates of laws: modules whose open names `osculate.kernel.compose` binds to parts."""
