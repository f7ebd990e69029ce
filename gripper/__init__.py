"""Compliant grippers: the bent shape and the contact forces of a flexible finger on a rigid outline."""
