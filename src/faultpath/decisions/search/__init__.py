"""Which fault hurts those most who choose by an isolated audit: bounds, proposals, record."""
