"""Ready parts by domain, as model files: data only."""
