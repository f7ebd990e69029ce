"""The beam: strain fields, its axis, sections, rest shape and strain energy."""
