"""Material laws beyond Hooke's: stress of a fibre, and what a section of such fibres answers."""

from gripper.laws.fibres import Fibre
from gripper.laws.response import Response, Tensor
from gripper.laws.section import SectionLaw, section_law

__all__ = ["Fibre", "Response", "SectionLaw", "Tensor", "section_law"]
