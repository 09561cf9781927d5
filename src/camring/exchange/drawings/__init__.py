"""What a designer takes home: files for CAD, grinding machine, spreadsheet and workshop."""

from camring.exchange.drawings.options import Wishes
from camring.exchange.drawings.products import DRAWN, PRODUCTS, chosen_products, export

__all__ = ["DRAWN", "PRODUCTS", "Wishes", "chosen_products", "export"]
