from erlif.review.comparison import *
