"""Templates of the engine: modules whose open names `osculate.kernel.compose` binds to parts."""
