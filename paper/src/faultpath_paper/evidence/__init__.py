"""Evidence on recorded windows: flights under correct inputs, and what models make of them."""
