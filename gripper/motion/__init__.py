"""Equilibria along a motion: followed, their changes located, with friction's memory."""
